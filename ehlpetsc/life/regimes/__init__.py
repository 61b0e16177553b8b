"""Lives of a case with [series], and which mechanism wins in each."""
