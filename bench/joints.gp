# Draws bench/out/joints.csv: how far a chain under 672 times the mass of a link opens, by substeps and by time.
if (picture[strlen(picture) - 3:*] eq ".svg") {
    set terminal svg noenhanced size 960,400 font "sans,12" background "#ffffff"
} else {
    set terminal pngcairo noenhanced size 960,400 font "sans,10"
}
set output picture
set datafile separator ","
set logscale xy
set border 3 lc rgb "#888888"
set tics nomirror
set grid ytics lc rgb "#dddddd"
set format y "%g"
set ylabel "widest gap of any joint in 20 s (mm)"
set multiplot layout 1, 2
rows(d, how) = sprintf("< awk -F, '$1 == %d && $3 == \"%s\"' %s", d, how, csv)
do for [k = 0:1] {
    if (k == 0) {
        set xlabel "substeps in a step of 1/60 s"
        set xtics (1, 2, 4, 8, 16, 32, 64)
        unset key
    } else {
        set xlabel "CPU time of a step (us)"
        set xtics auto
        unset ylabel
        set key top right samplen 2
    }
    plot rows(2, "iterations") using (k == 0 ? $4 : $6 / 1000):(1000 * $5) with linespoints pt 6 lc rgb "#ee7733" \
             title "iterations, 2D", \
         rows(3, "iterations") using (k == 0 ? $4 : $6 / 1000):(1000 * $5) with linespoints pt 7 lc rgb "#ee7733" \
             title "iterations, 3D", \
         rows(2, "direct") using (k == 0 ? $4 : $6 / 1000):(1000 * $5) with linespoints pt 6 lc rgb "#4477aa" \
             title "direct, 2D", \
         rows(3, "direct") using (k == 0 ? $4 : $6 / 1000):(1000 * $5) with linespoints pt 7 lc rgb "#4477aa" \
             title "direct, 3D"
}
unset multiplot
