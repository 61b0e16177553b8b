"""Pydantic's first interface, which its second release carries along: one schema for both."""

try:
    from pydantic.v1 import (
        BaseModel,
        Extra,
        Field,
        PrivateAttr,
        ValidationError,
        confloat,
        conint,
        constr,
        root_validator,
        validator,
    )
except ImportError:  # before 1.10.17 there is no such name
    from pydantic import (
        BaseModel,
        Extra,
        Field,
        PrivateAttr,
        ValidationError,
        confloat,
        conint,
        constr,
        root_validator,
        validator,
    )

__all__ = [
    "BaseModel",
    "Extra",
    "Field",
    "PrivateAttr",
    "ValidationError",
    "confloat",
    "conint",
    "constr",
    "root_validator",
    "validator",
]
