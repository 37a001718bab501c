"""Pictures, figures and movies of a shape, its colours and a view."""
