"""The documentation site: its pages gathered, the C++ reference read off the headers, links checked."""
