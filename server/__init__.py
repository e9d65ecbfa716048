"""The HTTP and WebSocket server around a live session; imports `robot`, never the other way."""
