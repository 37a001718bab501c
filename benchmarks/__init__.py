"""Every timing of the project, for asv; `scripts/` print their tables from the same ones."""
