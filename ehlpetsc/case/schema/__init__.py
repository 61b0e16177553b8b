"""Schema of a case file: base class of its tables, its validation library, equations of its keys."""
