"""What was made of measurements in steps: prepared scans beside models, their files, and what they were made from."""

import sqlalchemy as sa
from alembic import op

revision = "3"
down_revision = "2"


def upgrade() -> None:
    """Go to this version."""
    with op.batch_alter_table("models") as models:
        models.add_column(sa.Column("kind", sa.String(length=16), nullable=False, server_default="model"))
        models.add_column(sa.Column("steps", sa.Text(), nullable=False, server_default="[]"))
        models.add_column(sa.Column("files", sa.Text(), nullable=False, server_default="{}"))
    op.create_table(
        "model_parents",
        sa.Column("model_id", sa.Integer(), nullable=False),
        sa.Column("parent_id", sa.Integer(), nullable=False),
        sa.ForeignKeyConstraint(["model_id"], ["models.id"], name="fk_model_parents_model_id", ondelete="CASCADE"),
        sa.ForeignKeyConstraint(["parent_id"], ["models.id"], name="fk_model_parents_parent_id"),
        sa.PrimaryKeyConstraint("model_id", "parent_id", name="pk_model_parents"),
    )
