def page(m,f): return ''
