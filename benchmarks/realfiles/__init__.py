"""Real robots' files, from wheels of the Python package index, through this engine and through MuJoCo."""
