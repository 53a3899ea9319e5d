"""What Alembic runs to migrate: on the connection that `schema` hands over, within its transaction."""

from alembic import context

from clerestory.measure.database.schema import VERSION_TABLE
from clerestory.measure.database.tables import metadata

context.configure(
    connection=context.config.attributes["connection"],
    target_metadata=metadata,
    version_table=VERSION_TABLE,
    render_as_batch=True,  # SQLite alters tables by copying them
)
context.run_migrations()
