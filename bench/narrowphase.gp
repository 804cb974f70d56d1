# Draws bench/out/narrowphase.csv: what a query of a pair costs, by kinds of pairs. Bars: cold; dots: with what is
# remembered of the pair. Hollow: over 1 % of the answers are wrong, or off by over 1 mm.
set terminal pngcairo noenhanced size 1400,860 font "sans,10"
set output picture
set datafile missing NaN
set logscale y
set border 3 lc rgb "#888888"
set tics nomirror
set grid ytics lc rgb "#dddddd"
unset key
names = "physics/float physics/double physics/fixed32 physics_gjk_epa/float physics_gjk_mpr/float " . \
        "bullet_detector/float bullet_epa2/float bullet_boxes/float fcl_libccd/double fcl_indep/double " . \
        "libccd_gjk/double libccd_mpr/double box2d_2.4/float"
array colours[13] = [0x0044aa, 0x33bbee, 0x009988, 0x88bb44, 0xbbcc33, 0xcc3311, 0xee7733, 0xeeaa33, 0xaa3377, \
                     0xdd88bb, 0x664422, 0xaa8866, 0x888888]
# Lines `contestant place cold warm hollow width dot` for what one panel shows; a pair takes one unit of x.
awk = "awk -F, -v d=%d -v state='%s' -v task='%s' -v names='%s' '" . \
      "BEGIN {n = split(names, name, \" \"); for (i = 1; i <= n; ++i) number[name[i]] = i} " . \
      "$1 == d && $3 == state && $4 == task {k = number[$5 \"/\" $6]; if (!k) next; " . \
      "if (!($2 in pair)) {pair[$2] = pairs + 0; split($2, both, \"-\"); " . \
      "label[pairs++] = both[1] \"\\\\n\" (both[1] == both[2] ? \"\" : both[2])} " . \
      "there[k] = 1; at = pair[$2] \",\" k; " . \
      "if ($7 == \"cold\") cold[at] = $8; else warm[at] = $8; if (($13 + $14) > 0.01 * $15) bad[at] = 1} "
places = awk . "END {for (k in there) ++wide; for (p = 0; p < pairs; ++p) {slot = 0; " . \
         "for (k = 1; k <= n; ++k) if (k in there) {at = p \",\" k; ++slot; " . \
         "if (at in cold) print k, p + (slot - (wide + 1) / 2) / (wide + 1.5), cold[at], " . \
         "(at in warm) ? warm[at] : cold[at], bad[at] + 0, 0.85 / (wide + 1.5), (at in warm) * 0.6}}}' %s"
labels = awk . "END {for (p = 0; p < pairs; ++p) printf \"%%s\\\"%%s\\\" %%d\", p ? \", \" : \"\", label[p], p}' %s"
set multiplot layout 2,3 margins 0.04,0.99,0.15,0.91 spacing 0.035,0.11 \
    title "CPU time in ns a pair: bars cold, dots warm; hollow: over 1 % wrong or off by over 1 mm" font "sans,13"
array d[6] = [3, 3, 3, 3, 3, 2]
array state[6] = ["0.25 m apart", "1 cm deep", "60 % deep", "0.25 m apart", "1 cm deep", "1 cm deep"]
array task[6] = ["distance", "penetration", "penetration", "boolean", "manifold", "manifold"]
do for [i = 1:6] {
    set title sprintf("%dD, %s, %s", d[i], task[i], state[i])
    ticks = system(sprintf(labels, d[i], state[i], task[i], names, csv))
    if (strlen(ticks) == 0) { set multiplot next; continue }
    eval "set xtics (" . ticks . ") font 'sans,9'"
    set print $data
    print system(sprintf(places, d[i], state[i], task[i], names, csv))
    unset print
    set xrange [-0.6:*]
    # The key once, for all.
    if (i == 5) { set key at screen 0.5, screen 0.075 center top maxrows 2 samplen 1 } else { unset key }
    plot $data using 2:3:6:(colours[int($1)]) with boxes fs empty lc rgb variable notitle, \
         $data using ($5 == 0 ? $2 : NaN):3:6:(colours[int($1)]) with boxes fs solid 1 lc rgb variable notitle, \
         $data using 2:4:7 with points pt 7 ps variable lc rgb "black" notitle, \
         for [k = 1:words(names)] keyentry with boxes fs solid 1 lc rgb colours[k] title word(names, k)
}
unset multiplot
