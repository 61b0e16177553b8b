"""One module for each command: its arguments, its output and `main`.

Commands are the top of the package: only `ehlpetsc.__main__` imports them, by the names of its table. What
they call is below, in the folders that need no command line, so that no folder imports one above it.
"""
