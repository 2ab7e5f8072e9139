"""Every kind of disturbance once more: law, how examples are drawn, and what makes them strong."""
