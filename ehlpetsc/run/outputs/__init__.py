"""Outputs of a run, which receive every accepted state on every rank: see `ehlpetsc.run.solve.Output`."""
