"""Lives of a case with [series], and the winning mechanism of each."""
