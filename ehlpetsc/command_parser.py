"""Command lines of the commands beside the run: post, plot, study, compare and those of analysis."""

import argparse


class CommandParser(argparse.ArgumentParser):
    """argparse's, but for a bad command line: it ends in one sentence, status 2, without the usage."""

    def error(self, message):
        """Say what is wrong and how to see what there is; ends the command."""
        name = self.prog.removeprefix("python3 -m ")
        self.exit(2, f"{name}: {message}; {self.prog} -h lists the options\n")
