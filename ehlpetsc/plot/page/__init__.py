"""One result as one HTML page: its frame, style and script, and the numbers they show."""
