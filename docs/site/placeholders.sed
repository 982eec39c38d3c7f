# SPDX-License-Identifier: GPL-3.0-or-later
# Comments of headers have file names like <sensor>-depth.tif, which are not HTML.
s/<(name|output|ping|sensor)>/\&lt;\1\&gt;/g
