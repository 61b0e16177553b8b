"""Post-processing result files."""
