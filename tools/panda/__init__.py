"""Parts of the generator of the project's own Panda-like arm; see make_panda.py."""
