"""From the command line to a run: options, the case file, signals, and the streams of the process."""
