"""Command line of a run: options, case file, streams of the process."""
