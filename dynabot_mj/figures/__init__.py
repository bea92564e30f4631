"""Every figure, one file per subject; `style` says how all of them look. The only room with Matplotlib."""
