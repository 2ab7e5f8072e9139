"""The moving platform, integrated by scipy.integrate (DOP853), split at every jump."""
