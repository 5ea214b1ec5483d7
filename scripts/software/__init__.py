"""What the study `software` is made of: logs and their scans, the sources that answer their beams, odometry, ground
classification, and the figures that compare what such software makes of two scans of the same beams."""
