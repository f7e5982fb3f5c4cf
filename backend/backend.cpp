namespace groundloop {}
