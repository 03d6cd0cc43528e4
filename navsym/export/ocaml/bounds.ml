(* The kinds `cones` and `design` of docs/certificates.md: optima between weights and duals,
   and epochs of gross errors, by numbers alone. *)

open Text
open Ball

let sum = List.fold_left Q.add Q.zero
let dot x y = sum (List.map2 Q.mul x y)
let get_numbers what value = List.map (get_number what) (get_list what value)
let is_at_most x bound = sign_of (less x (of_rational bound)).hi <= 0

let of_width what n rows =
  if List.exists (fun row -> List.length row <> n) rows then refuse "%s: expected rows of %d entries" what n;
  rows

let get_vector what n value = List.hd (of_width what n [ get_numbers what value ])

(* x with M x = b, by Gauss in rationals with any pivot that is not 0, and whether all pivots were positive without exchange of rows *)
let rec solve_exactly rows =
  match rows with
  | [] -> ([], true)
  | _ ->
      let is_pivot (row, _) = Q.sign (List.hd row) <> 0 in
      let before, after = List.partition (fun r -> not (is_pivot r)) rows in
      let (pivot, b), after = match after with p :: l -> (p, l) | [] -> refuse "a linear system that may be singular" in
      let reduce (row, c) =
        let share = Q.div (List.hd row) (List.hd pivot) in
        (List.map2 (fun x p -> Q.sub x (Q.mul share p)) (List.tl row) (List.tl pivot), Q.sub c (Q.mul share b))
      in
      let rest, positive = solve_exactly (List.map reduce (before @ after)) in
      let first = Q.div (Q.sub b (dot (List.tl pivot) rest)) (List.hd pivot) in
      (first :: rest, positive && Q.sign (List.hd pivot) > 0 && is_pivot (List.hd rows))

(* One block: what its weights carry, their cost as a ball, and whether it allows noise *)
let read_block m value =
  match get_keys "block" [ "H"; "norm"; "size"; "weights" ] value with
  | [ h; norm; size; weights ] ->
      let h = of_width "H" m (List.map (get_numbers "H") (get_list "H" h)) in
      let p = List.length h in
      let w = get_vector "weights" p weights and rows = List.map (get_numbers "size") (get_list "size" size) in
      let is_signed = get_text "norm" norm = "nonpositive" in
      if p = 0 || List.length rows <> (if is_signed then 0 else p) then refuse "size: expected as many rows as weights";
      let carried = List.init m (fun j -> sum (List.map2 (fun row x -> Q.mul x (List.nth row j)) h w)) in
      let noise x = List.map (dot x) h in
      let scales () =
        let s = List.concat (of_width "size" 1 rows) in
        if List.exists (fun x -> Q.sign x <= 0) s then refuse "expected positive sizes";
        s
      in
      let cost, allows =
        match get_text "norm" norm with
        | "nonpositive" ->
            if List.exists (fun x -> Q.sign x < 0) w then refuse "a weight below zero";
            (ball_zero, List.for_all (fun r -> Q.sign r <= 0))
        | "linf" ->
            let s = scales () in
            (of_rational (dot s (List.map Q.abs w)), List.for_all2 (fun s r -> Q.leq (Q.abs r) s) s)
        | "l1" ->
            let s = scales () in
            let cost = List.fold_left2 (fun c s x -> Q.max c (Q.mul s (Q.abs x))) Q.zero s w in
            (of_rational cost, fun r -> Q.leq (sum (List.map2 (fun r s -> Q.div (Q.abs r) s) r s)) Q.one)
        | "l2" ->
            let rows = of_width "size" p rows in
            let entry i j = List.nth (List.nth rows i) j in
            let all f = List.for_all f (List.init p Fun.id) in
            let solved r = solve_exactly (List.combine rows r) in
            let is_symmetric = all (fun i -> all (fun j -> Q.equal (entry i j) (entry j i))) in
            let is_definite = is_symmetric && (match solved w with _, positive -> positive | exception Refused _ -> false) in
            if not is_definite then refuse "expected a positive definite size";
            (sqrt_ball (of_rational (dot w (List.map (dot w) rows))), fun r -> Q.leq (dot r (fst (solved r))) Q.one)
        | _ -> refuse "expected a norm"
      in
      (carried, cost, fun x -> allows (noise x))
  | _ -> assert false

let check_cones value ~at_precision =
  match get_keys "cones" [ "kind"; "blocks"; "functional"; "dual"; "lower"; "upper"; "bits" ] value with
  | [ _; blocks; functional; dual; lower; upper; bits ] ->
      at_precision (get_integer "bits" 53 20000 bits) (fun () ->
          let p = get_numbers "functional" functional in
          let m = List.length p in
          let x = get_vector "dual" m dual and blocks = List.map (read_block m) (get_list "blocks" blocks) in
          let total = List.fold_left (fun t (carried, _, _) -> List.map2 Q.add t carried) (List.map (fun _ -> Q.zero) p) blocks in
          if not (List.for_all2 Q.equal total p) then refuse "the weights do not carry the functional";
          let cost = List.fold_left (fun c (_, own, _) -> plus c own) ball_zero blocks in
          if not (is_at_most cost (get_number "upper" upper)) then refuse "the weights cost more than the upper bound";
          if not (List.for_all (fun (_, _, allows) -> allows x) blocks) then refuse "the dual leaves the noise";
          if Q.lt (dot x p) (get_number "lower" lower) then refuse "the lower bound is above x.P")
  | _ -> assert false

(* Sets of names are sorted lists. *)
let join a b = List.sort_uniq compare (a @ b)
let is_inside a b = List.for_all (fun x -> List.mem x b) a

type row = { h : json list; sigma : ball; needs : string list }

let number_of what value = Value.number_ball what (Tree.get_tree what value)

let read_row m prices value =
  match get_keys "row" [ "H"; "sigma"; "needs" ] value with
  | [ h; sigma; needs ] ->
      let h = List.hd (of_width "H" m [ get_list "H" h ]) and sigma = number_of "sigma" sigma in
      let needs = join [] (List.map (get_text "needs") (get_list "needs" needs)) in
      if not (is_above sigma) then refuse "a noise bound that is not positive";
      if not (List.for_all (fun n -> List.mem_assoc n prices) needs) then refuse "a row needs what has no cost";
      { h; sigma; needs }
  | _ -> assert false

let is_number = function Text _ as v -> (match get_number "number" v with _ -> true | exception Refused _ -> false) | _ -> false

(* The weights as balls, with whether each is 0; exact where all entries are numbers *)
let solve_support ?(exact = true) functional columns =
  let m = List.length functional in
  let rows read = List.init m (fun i -> (List.map (fun c -> read (List.nth c i)) columns, read (List.nth functional i))) in
  if exact && List.for_all is_number (functional @ List.concat columns) then
    List.map (fun w -> (of_rational w, Q.sign w = 0)) (fst (solve_exactly (rows (get_number "support"))))
  else
    match Gap.solve (rows (number_of "support")) with
    | weights -> List.map (fun w -> (w, is_exactly_zero w)) weights
    | exception No_value -> refuse "a linear system that may be singular"

(* No purchase within the budget meets every set of needs. *)
let search ~left ~prices ~most failing =
  let is_affordable names = Q.leq (sum (List.map (fun n -> List.assoc n prices) names)) most in
  let left = ref left in
  let rec look bought =
    if !left = 0 then refuse "more selections than announced";
    decr left;
    let open_ones = List.filter (fun sets -> not (List.exists (fun n -> is_inside n bought) sets)) failing in
    let fewest best sets = match best with Some b when List.length b <= List.length sets -> best | _ -> Some sets in
    match List.fold_left fewest None open_ones with
    | None -> refuse "a selection within the budget may do better"
    | Some sets -> List.iter (fun n -> let more = join n bought in if is_affordable more then look more) sets
  in
  is_affordable, look

let check_design value ~at_precision =
  match get_keys "design" [ "kind"; "rows"; "costs"; "budget"; "functional"; "support"; "duals"; "lower"; "upper"; "bits"; "cells" ] value with
  | [ _; rows; costs; budget; functional; support; duals; lower; upper; bits; cells ] ->
      let bits = Goal.get_bits 20000 bits in
      let left = Value.cells_allowed (get_integer "cells" 0 (Value.most_cells bits) cells) in
      at_precision bits (fun () ->
          let prices = List.map (fun (n, v) -> (n, get_number "costs" v)) (get_object "costs" costs) in
          if List.exists (fun (_, c) -> Q.sign c < 0) prices then refuse "a negative cost";
          let functional = get_list "functional" functional in
          let m = List.length functional in
          let rows = List.map (read_row m prices) (get_list "rows" rows) in
          let count = List.length rows in
          let chosen = List.map (get_integer "support" 0 (count + m - 1)) (get_list "support" support) in
          if List.length chosen <> m || List.length (List.sort_uniq compare chosen) <> m then refuse "support: expected %d different numbers" m;
          let unit k = List.init m (fun i -> Text (if i = k then "1" else "0")) in
          let column k = if k < count then (List.nth rows k).h else unit (k - count) in
          let weights = solve_support functional (List.map column chosen) in
          let used = List.filter (fun (_, (_, is_zero)) -> not is_zero) (List.combine chosen weights) in
          if List.exists (fun (k, _) -> k >= count) used then refuse "a weight that stands at no row";
          let cost = List.fold_left (fun c (k, (w, _)) -> plus c (times (List.nth rows k).sigma (size w))) ball_zero used in
          if not (is_at_most cost (get_number "upper" upper)) then refuse "the weights cost more than the upper bound";
          let functional = List.map (number_of "functional") functional and lower = get_number "lower" lower in
          let h = List.map (fun row -> List.map (number_of "H") row.h) rows in
          let product x y = List.fold_left2 (fun s a b -> plus s (times (of_rational a) b)) ball_zero x y in
          let fails_at dual =
            let x = get_vector "duals" m dual in
            if sign_of (less (product x functional) (of_rational lower)).lo < 0 then refuse "the lower bound is above x.P";
            let fails row h = sign_of (less (size (product x h)) row.sigma).hi > 0 in
            List.sort_uniq compare (List.concat (List.map2 (fun row h -> if fails row h then [ row.needs ] else []) rows h))
          in
          let failing = List.map fails_at (get_list "duals" duals) in
          let is_affordable, look = search ~left ~prices ~most:(get_number "budget" budget) failing in
          let needed = List.fold_left (fun all (k, _) -> join (List.nth rows k).needs all) [] used in
          if not (is_affordable needed) then refuse "the weights need more than the budget";
          look (List.sort compare (List.map fst (List.filter (fun (_, c) -> Q.sign c = 0) prices))))
  | _ -> assert false

type reading = { epoch : Q.t; regressor : json list; z : ball; bound : ball }

(* Whether at most so many epochs, `without` not among them, are met by all sets: one of them is in the first. *)
let rec can_meet left without most met =
  decr left;
  if !left < 0 then refuse "more sets than announced";
  let misses e = List.filter (fun set -> not (List.exists (Q.equal e) set)) in
  match met with
  | [] -> true
  | first :: _ ->
      let try_epoch e = (not (Q.equal e without)) && can_meet left without (most - 1) (misses e met) in
      most > 0 && List.exists try_epoch first

let check_exclusion value ~at_precision =
  match get_keys "exclusion" [ "kind"; "rows"; "most"; "excluded"; "contradictions"; "bits"; "cells" ] value with
  | [ _; rows; most; excluded; contradictions; bits; cells ] ->
      let bits = get_integer "bits" 53 20000 bits and most = get_integer "most" 0 4 most in
      let left = ref (Value.cells_allowed (get_integer "cells" 0 (Value.most_cells bits) cells)) in
      at_precision bits (fun () ->
          let read v =
            match get_keys "row" [ "epoch"; "H"; "z"; "sigma" ] v with
            | [ epoch; h; z; sigma ] ->
                let sigma = get_number "sigma" sigma in
                if Q.sign sigma < 0 then refuse "expected noise bounds that are not negative";
                let bound = of_rational sigma and z = of_rational (get_number "z" z) in
                { epoch = get_number "epoch" epoch; regressor = get_list "H" h; z; bound }
            | _ -> assert false
          in
          let table = List.map read (get_list "rows" rows) in
          let entries = List.concat_map (fun row -> row.regressor) table in
          let exact = List.for_all is_number entries in
          List.iter (fun e -> ignore (number_of "H" e)) entries;
          let find k = List.nth table (get_integer "contradictions" 0 (List.length table - 1) k) in
          let total = List.fold_left plus ball_zero in
          let meet places =
            match List.rev_map find (get_list "contradictions" places) with
            | [] -> refuse "contradictions: expected rows"
            | last :: basis ->
                let m = List.length basis in
                let columns = of_width "H" m (List.map (fun row -> row.regressor) (last :: basis)) in
                let weights = solve_support ~exact (List.hd columns) (List.tl columns) in
                let used = List.filter (fun (_, (_, is_zero)) -> not is_zero) (List.combine basis weights) in
                let shift = total (List.map (fun (row, (w, _)) -> times w row.z) used) in
                let noise = total (List.map (fun (row, (w, _)) -> times (size w) row.bound) used) in
                let distance = size (less last.z shift) in
                if not (is_above (less distance (plus last.bound noise))) then refuse "no contradiction";
                List.map (fun row -> row.epoch) (last :: List.map fst used)
          in
          let met = List.map meet (get_list "contradictions" contradictions) in
          let check e = if can_meet left e most met then refuse "a set without the epoch may explain the data" in
          List.iter (fun e -> check (get_number "excluded" e)) (get_list "excluded" excluded))
  | _ -> assert false
