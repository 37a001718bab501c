"""Files: bytes that come in and go out, whatever is in them."""
