"""Interface of pydantic 1, which pydantic 2 includes: one schema for both releases."""

try:
    from pydantic import v1 as pydantic
except ImportError:  # before 1.10.17
    import pydantic

BaseModel, Extra, Field = pydantic.BaseModel, pydantic.Extra, pydantic.Field
PrivateAttr, ValidationError = pydantic.PrivateAttr, pydantic.ValidationError
confloat, conint, constr = pydantic.confloat, pydantic.conint, pydantic.constr
root_validator, validator = pydantic.root_validator, pydantic.validator
