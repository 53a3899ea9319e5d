"""Versions of the schema, in order; what was released is never changed."""
