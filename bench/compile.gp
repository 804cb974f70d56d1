# Draws bench/out/compile.csv: a cluster of bars a row, one bar a compiler, and the budget as a line across its cluster.
set terminal pngcairo noenhanced size 960,540 font "sans,11"
set output picture
set datafile separator ","
set title "CPU seconds at -O2 (minimum); include costs over an empty unit" font "sans,13"
set style fill solid 0.9 noborder
set boxwidth 0.38
set border 3 lc rgb "#888888"
set tics nomirror
set xtics rotate by -25
set yrange [0:*]
set offsets 0.3, 0.3, 0.2, 0
set key top left
# Rows alternate: g++, clang++; the first line names the columns.
plot csv every 2::1 using ($0 - 0.2):3:xtic(1) with boxes lc rgb "#4477aa" title "g++", \
     csv every 2::2 using ($0 + 0.2):3 with boxes lc rgb "#ee7733" title "clang++", \
     csv every 2::1 using ($0 - 0.2):3:(sprintf("%.2f", $3)) with labels offset 0, 0.6 font ",9" notitle, \
     csv every 2::2 using ($0 + 0.2):3:(sprintf("%.2f", $3)) with labels offset 0, 0.6 font ",9" notitle, \
     csv every 2::1 using 0:(strlen(strcol(5)) ? column(5) : 1/0):(0.42) with xerrorbars pt -1 lw 3 lc rgb "#cc3311" title "budget"
