"""The two kinds of robots behind one protocol: `particle` (point masses) and `rigid_body` (MuJoCo)."""
