"""What the archives hold."""
