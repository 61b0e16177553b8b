"""The post-processing result file: written, and read back."""
