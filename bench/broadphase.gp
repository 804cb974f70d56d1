# Draws bench/out/broadphase.csv: uniform worlds, in 3D above and 2D below; what a frame costs a proxy, and a ray, over
# the number of proxies. Flat is good: the price of a proxy does not depend on how many others there are.
set terminal pngcairo noenhanced size 1200,760 font "sans,10"
set output picture
set datafile separator ","
set datafile missing NaN
set logscale xy
set format x "%.0s%c"
set border 3 lc rgb "#888888"
set tics nomirror
set grid ytics lc rgb "#dddddd"
set xlabel "proxies"
set key below samplen 2 width 2
colours = "#0044aa #33bbee #009988 #88bb44 #aaaaaa #cc3311 #ee7733 #eeaa33 #aa3377 #664422"
# Who is in a panel, as NUMBER=NAME: a contestant has the same number, so the same colour, in all of them.
panel(d, what) = system("awk -F, -v d=" . d . " -v what='" . what . "' '" . \
    "!($4 in n) {n[$4] = NR > 1 ? ++k : 0} " . \
    "$1 == \"uniform\" && $2 == d && $5 == \"float\" && $6 == what && !seen[$4]++ {print n[$4] \"=\" $4}' " . csv)
name(entry) = substr(entry, strstrt(entry, "=") + 1, strlen(entry))
colour(entry) = word(colours, 1 + (int(entry[1:strstrt(entry, "=") - 1]) - 1) % words(colours))
mine(d, entry, what) = strcol(1) eq "uniform" && column(2) == d && strcol(4) eq name(entry) && \
                       strcol(5) eq "float" && strcol(6) eq what
set multiplot layout 2,3 \
    title "CPU time in ns (mean); uniform worlds of boxes of 0.5 to 1 m with two neighbours each" font "sans,13"
do for [d = 3:2:-1] {
    do for [k = 1:3] {
        what = k == 1 ? "frame 1 %" : k == 2 ? "frame 100 %" : "ray"
        set title sprintf(k == 3 ? "%dD, %s" : "%dD, %s moving, a proxy", d, what)
        all = panel(d, what)
        if (words(all) == 0) { set multiplot next; continue }
        plot for [entry in all] csv skip 1 using 3:(mine(d, entry, what) ? column(7) : NaN) with linespoints \
             lw 2 pt 7 ps 0.7 lc rgb colour(entry) title name(entry)
    }
}
unset multiplot
