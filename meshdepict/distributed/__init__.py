"""Work of many parts, done by several processes here or by a Dask cluster."""
