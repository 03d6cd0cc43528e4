"""placeholder"""
def suggest(entry, scope, decision):
    return None
