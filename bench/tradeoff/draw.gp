# Draws bench/tradeoff/fronts.svg and fronts3.svg: error against CPU time of each scene, 2D and 3D; and substeps.svg:
# error of the soft step by substeps. folder: that of bench/out/tradeoff/*.dat; engines2, colours2, scenes2, and the same
# with 3: words.
set terminal svg noenhanced size 1200,1250 font "sans,11" background "#ffffff"
set datafile separator ","
set border 3 lc rgb "#888888"
set tics nomirror
set grid lc rgb "#eeeeee"
set logscale xy
set format "%.0e"
do for [space = 0:1] {
    set output "bench/tradeoff/fronts".(space ? "3" : "").".svg"
    names = space ? scenes3 : scenes2
    engines = space ? engines3 : engines2
    colours = space ? colours3 : colours2
    set multiplot layout 5, 3
    do for [i = 1:words(names)] {
        name = word(names, i)
        set title name font ",13"
        set key off
        set xlabel (i > words(names) - 3 ? "CPU seconds a simulated second" : "")
        plot for [k = 1:words(engines)] sprintf("< grep -h '^%s,%s,' %s/all.dat", name, word(engines, k), folder) \
                 using 3:4 with points pt 7 ps 0.2 lc rgb word(colours, k) notitle, \
             for [k = 1:words(engines)] sprintf("< grep -h '^%s,%s,' %s/front.dat", name, word(engines, k), folder) \
                 using 3:4 with steps lw 2 lc rgb word(colours, k) notitle, \
             sprintf("< grep -h '^%s,' %s/visible.dat", name, folder) using 2:3 \
                 with lines dt 3 lc rgb "#444444" notitle, \
             sprintf("< grep -h '^%s,' %s/failed.dat", name, folder) using 3:4:5 with points pt 2 ps 0.5 \
                 lc rgb variable notitle
    }
    set title "engines"
    set key inside left top Left reverse samplen 1 width -2 font ",9" maxrows 8
    unset tics
    unset border
    unset grid
    set xlabel ""
    set xrange [1:2]
    set yrange [1:2]
    plot for [k = 1:words(engines)] NaN with lines lw 3 lc rgb word(colours, k) title word(engines, k), \
         NaN with lines dt 3 lc rgb "#444444" title "just visible", \
         NaN with points pt 2 lc rgb "#444444" title "not solved"
    unset multiplot
    set tics nomirror
    set border 3 lc rgb "#888888"
    set grid lc rgb "#eeeeee"
    set autoscale
}
set terminal svg noenhanced size 960,480 font "sans,12" background "#ffffff"
set output "bench/tradeoff/substeps.svg"
set xrange [0.9:72]
set key outside right maxrows 20
scene_colours = "#0044aa #66aaee #9955bb #008855 #77cc99 #dd2222 #ee8833 #bb7700 #ee66aa #222222 #888888 #00aaaa"
scene_colours = scene_colours." #aaaa00 #aa0044"
set title ""
set xlabel "substeps in a step of 1/60 s (soft_step, float, 2D)"
set ylabel "error / what is just visible"
set format x "%g"
set xtics (1, 2, 4, 8, 16, 32, 64)
plot for [i = 1:words(scenes2)] sprintf("< grep -h '^%s,' %s/substeps.dat", word(scenes2, i), folder) \
         using 2:3 with linespoints pt i ps 0.7 lc rgb word(scene_colours, (i - 1) % words(scene_colours) + 1) title word(scenes2, i), \
     1 with lines dt 3 lc rgb "#444444" title "just visible"
