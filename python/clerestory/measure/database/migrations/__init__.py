"""How the schema of the laboratory's database came to be, a file a version; Alembic walks them."""
