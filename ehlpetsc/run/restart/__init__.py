"""State of a run in a restart file: content, check, conversion to the scales of another case."""
