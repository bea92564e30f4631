"""One trial frame by frame: recorded, set up as a MuJoCo model, played back, in a window or in the browser."""
