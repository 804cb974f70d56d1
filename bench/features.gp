# Draws bench/out/features.csv: what leaving a feature out changes, in percent of the whole recipe, by scene.
set terminal pngcairo noenhanced size 1200,560 font "sans,10"
set output picture
set datafile separator ","
set style data histograms
set style histogram clustered gap 2
set style fill solid 0.9 noborder
set border 3 lc rgb "#888888"
set tics nomirror
set grid ytics lc rgb "#dddddd"
set xtics rotate by -30
set ylabel "of the whole recipe (%)"
set yrange [0:*]
set key below samplen 1
dimensions = system("awk -F, 'NR > 1 && !s[$1]++ {print $1}' " . csv)
set multiplot layout 1, words(dimensions)
do for [d = 1:words(dimensions)] {
    rows = "< awk -F, -v d=" . word(dimensions, d) . " 'NR > 1 && $1 == d' " . csv
    set title word(dimensions, d) . "D: what is left when features are left out"
    stats rows using 3 every ::0::0 nooutput name "A"
    stats rows using 7 every ::0::0 nooutput name "B"
    stats rows using 11 every ::0::0 nooutput name "C"
    stats rows using 18 every ::0::0 nooutput name "E"
    plot rows using (100 * $3 / A_max):xtic(2) lc rgb "#4477aa" title "resting", \
         rows using (100 * $7 / B_max) lc rgb "#ee7733" title "tumbling", \
         rows using (100 * $11 / C_max) lc rgb "#009988" title "falling", \
         rows using (100 * $18 / E_max) lc rgb "#bbbbbb" title "code"
}
unset multiplot
