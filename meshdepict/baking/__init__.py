"""From a shape and a look to colours that can be kept."""
