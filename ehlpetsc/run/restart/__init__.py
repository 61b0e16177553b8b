"""A run's state in a restart file: what it holds, checked as a case is, brought to the units of a case."""
