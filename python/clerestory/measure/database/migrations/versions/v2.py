"""What is made of measurements: models and reports, with what each was made of."""

import sqlalchemy as sa
from alembic import op

revision = "2"
down_revision = "1"


def upgrade() -> None:
    """Go to this version."""
    op.create_table(
        "models",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("sample_id", sa.Integer(), nullable=False),
        sa.Column("name", sa.Text(), nullable=False),
        sa.Column("file_name", sa.Text(), nullable=False),
        sa.Column("blob_id", sa.Integer(), nullable=False),
        sa.Column("command", sa.Text(), nullable=False),
        sa.Column("settings", sa.Text(), nullable=False),
        sa.Column("version", sa.Text(), nullable=False),
        sa.Column("made", sa.DateTime(timezone=True), nullable=False),
        sa.ForeignKeyConstraint(["blob_id"], ["blobs.id"], name="fk_models_blob_id"),
        sa.ForeignKeyConstraint(["sample_id"], ["samples.id"], name="fk_models_sample_id"),
        sa.PrimaryKeyConstraint("id", name="pk_models"),
        sa.UniqueConstraint("sample_id", "name", name="uq_models_sample_id"),
    )
    op.create_table(
        "reports",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("name", sa.Text(), nullable=False),
        sa.Column("file_name", sa.Text(), nullable=False),
        sa.Column("blob_id", sa.Integer(), nullable=False),
        sa.Column("made", sa.DateTime(timezone=True), nullable=False),
        sa.ForeignKeyConstraint(["blob_id"], ["blobs.id"], name="fk_reports_blob_id"),
        sa.PrimaryKeyConstraint("id", name="pk_reports"),
        sa.UniqueConstraint("name", name="uq_reports_name"),
    )
    op.create_table(
        "report_models",
        sa.Column("report_id", sa.Integer(), nullable=False),
        sa.Column("model_id", sa.Integer(), nullable=False),
        sa.ForeignKeyConstraint(["model_id"], ["models.id"], name="fk_report_models_model_id"),
        sa.ForeignKeyConstraint(["report_id"], ["reports.id"], name="fk_report_models_report_id", ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("report_id", "model_id", name="pk_report_models"),
    )
    op.create_table(
        "model_scans",
        sa.Column("model_id", sa.Integer(), nullable=False),
        sa.Column("scan_id", sa.Integer(), nullable=False),
        sa.ForeignKeyConstraint(["model_id"], ["models.id"], name="fk_model_scans_model_id", ondelete="CASCADE"),
        sa.ForeignKeyConstraint(["scan_id"], ["scans.id"], name="fk_model_scans_scan_id"),
        sa.PrimaryKeyConstraint("model_id", "scan_id", name="pk_model_scans"),
    )
    op.create_table(
        "model_sphere_values",
        sa.Column("model_id", sa.Integer(), nullable=False),
        sa.Column("sphere_value_id", sa.Integer(), nullable=False),
        sa.ForeignKeyConstraint(
            ["model_id"], ["models.id"], name="fk_model_sphere_values_model_id", ondelete="CASCADE"
        ),
        sa.ForeignKeyConstraint(
            ["sphere_value_id"], ["sphere_values.id"], name="fk_model_sphere_values_sphere_value_id"
        ),
        sa.PrimaryKeyConstraint("model_id", "sphere_value_id", name="pk_model_sphere_values"),
    )
