"""Reports on samples, and checks: what was said of which scans and sphere values."""

import sqlalchemy as sa
from alembic import op

revision = "4"
down_revision = "3"


def upgrade() -> None:
    """Go to this version."""
    with op.batch_alter_table("reports") as reports:
        reports.add_column(sa.Column("kind", sa.String(length=16), nullable=False, server_default="report"))
    for what in ("sample", "scan", "sphere_value"):
        name = f"report_{what}s"
        op.create_table(
            name,
            sa.Column("report_id", sa.Integer(), nullable=False),
            sa.Column(f"{what}_id", sa.Integer(), nullable=False),
            sa.ForeignKeyConstraint(["report_id"], ["reports.id"], name=f"fk_{name}_report_id", ondelete="CASCADE"),
            sa.ForeignKeyConstraint([f"{what}_id"], [f"{what}s.id"], name=f"fk_{name}_{what}_id"),
            sa.PrimaryKeyConstraint("report_id", f"{what}_id", name=f"pk_{name}"),
        )
