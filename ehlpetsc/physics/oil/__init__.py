"""Laws of the oil and measured oils."""
