"""Tests, mirroring the packages; a package, so that it comes before the standard library's own `test`."""
