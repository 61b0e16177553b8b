"""HTML page of one result: template, style, script and data."""
